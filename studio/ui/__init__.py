"""What a person sees. The only layer that may import Qt."""
