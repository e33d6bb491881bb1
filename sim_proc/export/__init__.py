"""`legpush export`: writes recordings as files for other programs."""
