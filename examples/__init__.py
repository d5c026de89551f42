"""Programs that use Stribeck; nothing imports them."""
