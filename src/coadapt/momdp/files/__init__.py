"""Problems and policies in files: `.pomdp`, `.pomdpx`, `.policyx` and a compact format."""

from coadapt.momdp.files.policies import read_policy, write_policy
from coadapt.momdp.files.pomdpx_writer import write_pomdpx
from coadapt.momdp.files.problems import read_pomdp

__all__ = ["read_policy", "read_pomdp", "write_policy", "write_pomdpx"]
