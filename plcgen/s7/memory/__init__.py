"""How much work memory a program takes, estimated from its sources; the rules are in README.md."""
