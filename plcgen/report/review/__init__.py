"""The review page: everything that a reviewer must see before signing, collected from the other rooms and arranged."""
