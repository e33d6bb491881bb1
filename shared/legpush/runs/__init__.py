"""The runs on this machine: their folders, and which of them are live."""
