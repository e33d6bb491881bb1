"""Work that takes long: its progress, and its finished parts, which an interrupted program keeps."""
