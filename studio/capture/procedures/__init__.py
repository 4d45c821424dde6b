"""What an operator is led through step by step: state machines without a window and without a clock."""
