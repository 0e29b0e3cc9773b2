"""The boundary with SUNDIALS: names, memory, callbacks.

No other room knows an address.
"""
