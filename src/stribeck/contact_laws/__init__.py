"""Contact laws: the pressure of the asperities at a separation of the surfaces."""
