"""Laws as objects of other Python libraries."""

TARGET = None  # these hand over objects and write no files
