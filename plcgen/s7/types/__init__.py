"""The S7 type system under standard access: types, blocks, layout, literals, addresses, names. No I/O."""
