"""Human pose to reference pose."""
