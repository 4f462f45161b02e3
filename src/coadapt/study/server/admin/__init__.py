"""The researcher's side of a study's server."""

from coadapt.study.server.admin.desk import Desk
from coadapt.study.server.admin.routes import admin_routes

__all__ = ["Desk", "admin_routes"]
