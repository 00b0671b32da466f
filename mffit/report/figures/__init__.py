"""The pictures: each function takes a view and returns a figure."""
