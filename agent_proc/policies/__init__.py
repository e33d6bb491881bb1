"""Policies decide about each push; the shipped ones lie here."""
