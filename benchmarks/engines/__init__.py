"""What the engines of studies cost, and how many workers one head can keep busy."""
