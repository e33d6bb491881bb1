"""Tables of whole missions, most of them in random rooms."""
