"""How it is shown: tables, plots, pictures, pages and their templates."""
