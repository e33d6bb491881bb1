"""Searches a route for the trunk, with trees and roadmaps."""
