"""What drives a robot: the protocol, a simulated robot in process, any other by UDP."""
