"""What simulations tell: laws beside each other, limit cycles, and whether a servo's gains hold."""
