"""HTTP without a wire: questions go from the driver's session straight to an emulated camera, three times as fast."""

from __future__ import annotations

from io import BytesIO
from typing import Any
from urllib.parse import parse_qsl, urlsplit

import requests
from requests.adapters import BaseAdapter
from urllib3 import HTTPHeaderDict, HTTPResponse

from surveillance_domain.emulation.camera import EmulatedCamera, Question, Reply

__all__ = ["direct_session"]


def direct_session(camera: EmulatedCamera) -> requests.Session:
    """A session that asks this camera, whatever the address; in virtual time."""
    session = requests.Session()
    session.mount("http://", _Direct(camera))
    return session


class _Direct(BaseAdapter):
    def __init__(self, camera: EmulatedCamera) -> None:
        super().__init__()
        self._camera = camera

    def send(
        self,
        request: requests.PreparedRequest,
        stream: bool = False,
        timeout: Any = None,
        verify: Any = True,
        cert: Any = None,
        proxies: Any = None,
    ) -> requests.Response:
        target = request.path_url
        parts = urlsplit(target)
        query = dict(parse_qsl(parts.query, keep_blank_values=True))
        reply = self._camera.reply(
            Question(target, parts.path, query, request.headers.get("Authorization"), timeout[1])
        )
        if reply is None:
            raise requests.exceptions.ConnectionError("closed without an answer", request=request)
        return self._response(request, reply)

    def close(self) -> None:
        return None

    def _response(self, request: requests.PreparedRequest, reply: Reply) -> requests.Response:
        headers = HTTPHeaderDict([*reply.headers, ("Content-Length", str(len(reply.body)))])
        body = BytesIO(reply.body[: reply.cut_at])
        raw = HTTPResponse(body, headers, reply.status, preload_content=False, enforce_content_length=True)
        raw.length_remaining = len(reply.body)
        response = requests.Response()
        response.status_code = reply.status
        response.headers = requests.structures.CaseInsensitiveDict(headers)
        response.raw, response.request, response.url = raw, request, request.url or ""
        response.connection = self  # type: ignore[attr-defined]
        return response
