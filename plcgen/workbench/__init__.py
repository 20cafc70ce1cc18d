"""What editors and the page of ``serve`` show of specs and sources while somebody types."""
