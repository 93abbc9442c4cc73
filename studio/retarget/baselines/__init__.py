"""The simplest honest methods a mapper is compared with."""
