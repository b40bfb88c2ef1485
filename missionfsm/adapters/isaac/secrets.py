"""Tokens and certificates, read from files. Everything raises UnreadableError with the file and what is wrong."""

from __future__ import annotations

import json
import ssl
from pathlib import Path

from missionfsm.kernel.codec import UnreadableError


def tokens(path: str) -> dict[str, str]:
    """The token of every robot's name: a JSON object of texts."""
    text = _text(path)
    try:
        found = json.loads(text)
    except ValueError:
        found = None
    if not isinstance(found, dict) or not all(isinstance(token, str) and token for token in found.values()):
        raise UnreadableError(f'{path}: wanted a JSON object of names and tokens, such as {{"carter-01": "…"}}')
    return found


def token(path: str) -> str:
    """The token of one robot: the first line."""
    found = _text(path).partition("\n")[0].strip()
    if not found:
        raise UnreadableError(f"{path}: holds no token")
    return found


def server_tls(certificate: str, key: str) -> ssl.SSLContext:
    """How a server shows who it is: a certificate (with its chain) and its key, both PEM."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    try:
        context.load_cert_chain(certificate, key)
    except OSError as error:  # an SSLError is one too
        raise UnreadableError(f"{certificate}, {key}: {error.strerror or error}") from None
    return context


def client_tls(authority: str) -> ssl.SSLContext:
    """Whom a robot believes: certificates, PEM."""
    try:
        return ssl.create_default_context(cafile=authority)
    except OSError as error:
        raise UnreadableError(f"{authority}: {error.strerror or error}") from None


def _text(path: str) -> str:
    try:
        return Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise UnreadableError(f"{path}: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise UnreadableError(f"{path}: not UTF-8") from None
