"""Between pages and models: each joins one page to what it shows and does."""
