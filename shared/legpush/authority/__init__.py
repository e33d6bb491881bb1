"""A certificate authority of one's own: it signs the certificates of all processes, and lists who may take part."""
