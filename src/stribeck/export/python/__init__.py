"""Laws as objects of other Python libraries."""
