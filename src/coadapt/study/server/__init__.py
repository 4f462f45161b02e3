"""The web server of a study: pages, the trials' websocket, the researcher's side."""
