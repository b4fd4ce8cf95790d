"""The documentation site: what in it is made from the code and from the kept rows. See mkdocs.yml."""
