"""Tables and pictures of the studies, made from their rows."""
