"""The MCAP file format: records, a writer and a reader."""
