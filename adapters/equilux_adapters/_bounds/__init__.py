"""What bounds over a whole picture are made of, for adapters that cut what a scene asks for: how near lights are to surfaces, how
much a ray may bring."""
