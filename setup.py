"""Builds the Python package ipc_cffi: what pyproject.toml cannot say."""
from setuptools import setup

setup(cffi_modules=["python/ipc_cffi/_build.py:ffibuilder"],
      options={"bdist_wheel": {"py_limited_api": "cp39"}})
