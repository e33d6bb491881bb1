"""Tables and pictures of the benchmarks that are studies, made from their rows."""
