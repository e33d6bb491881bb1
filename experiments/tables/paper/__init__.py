"""Tables and pictures of what the paper states in figures and equations, beside what is measured here."""
