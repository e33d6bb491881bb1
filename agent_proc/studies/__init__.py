"""Kinds of cells for studies, and the tables and pictures of their rows."""
