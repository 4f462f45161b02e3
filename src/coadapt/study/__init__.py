"""Studies that people take part in (Sec. 6): their protocol, their sessions, their data."""
