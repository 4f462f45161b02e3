"""The report of any task: its world, what its robots do in it, with whom, how well."""
