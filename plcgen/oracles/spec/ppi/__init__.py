"""PPI masters: ``statement`` says what every job does, ``stations`` reads and answers its telegrams."""
