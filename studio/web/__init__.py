"""The page: gateway, viser scene, panels."""
