"""Mutual TLS: the certificate of a process, what each role may say and hear, and why a process is refused."""
