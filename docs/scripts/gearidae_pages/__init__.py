"""Tables and pictures of the documentation: ``python -m gearidae_pages.NAME`` with this folder on the Python path."""
