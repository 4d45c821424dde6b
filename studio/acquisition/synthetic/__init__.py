"""A performer with 1 to 15 tags whose true motion is known: a judge, not a friend (contracts, section 8)."""
