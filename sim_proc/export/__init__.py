"""`legpush export`: recordings as files of other programs."""
