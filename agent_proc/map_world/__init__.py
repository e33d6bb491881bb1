"""A world made of measured pushes with their residuals: it moves the box without physics, many times as fast."""
