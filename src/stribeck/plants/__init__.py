"""What a friction law acts on."""
