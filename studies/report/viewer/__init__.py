"""The 3D view in a page: a body's surface in its states, packed into the page, turned and coloured in the browser."""
