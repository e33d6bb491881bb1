"""Terms of rewards: what the paper and its code pay, and progress."""
