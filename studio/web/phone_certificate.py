"""Where a phone reaches this machine, and the certificate that this machine makes for it."""

import contextlib
import datetime
import ipaddress
import os
import socket
import ssl
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID

from studio.errors import StudioError
from studio.files import open_regular, write_whole

FILE = ".phone.pem"
"""Key and certificate, in the folder of takes: a phone that trusted it once need not again."""
DAYS = 365
AUTO = "auto"


def address_for(said: str) -> str:
    """The address that a phone can reach: the one given, or for `auto` this machine's in its
    network. StudioError where there is none, or it is no address of one network."""
    if said == AUTO:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as way:
            try:
                way.connect(("192.0.2.1", 9))  # nothing is sent: it only chooses a way out
                return str(way.getsockname()[0])
            except OSError as error:
                raise StudioError(
                    "--phone auto found no network: give this machine's address in it, such as "
                    "--phone 192.168.1.20"
                ) from error
    try:
        found = ipaddress.ip_address(said)
    except ValueError:
        found = None
    mapped = getattr(found, "ipv4_mapped", None)
    found = mapped or found
    if found is None or found.is_unspecified or found.is_multicast or found.is_reserved:
        raise StudioError(
            "--phone takes the address of this machine that the phone can reach, such as "
            "192.168.1.20, or auto"
        )
    return found.compressed


def certificate(folder: Path, address: str) -> Path:
    """A file with a certificate for the address and its key; made where there is none that is good
    for a day more. StudioError if it cannot be written."""
    file, day = folder / FILE, datetime.timedelta(days=1)
    now, ours = datetime.datetime.now(datetime.UTC), ipaddress.ip_address(address)
    with contextlib.suppress(OSError, ValueError, StudioError, x509.ExtensionNotFound):
        with open_regular(file, 65_536) as kept:
            known = x509.load_pem_x509_certificate(kept.read())
        ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(file)  # with its own key
        about = file.lstat()
        names = known.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
        private = about.st_uid == os.getuid() and not about.st_mode & 0o077
        fits = ours in names.get_values_for_type(x509.IPAddress)
        if private and fits and now + day < known.not_valid_after_utc:
            return file
    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "A1 Studio")])
    made = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - day)
        .not_valid_after(now + DAYS * day)
        .add_extension(x509.SubjectAlternativeName([x509.IPAddress(ours)]), critical=False)
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(x509.ExtendedKeyUsage([x509.OID_SERVER_AUTH]), critical=False)
        .sign(key, hashes.SHA256())
    )
    plain = serialization.NoEncryption()
    form = serialization.PrivateFormat.PKCS8
    pem = key.private_bytes(serialization.Encoding.PEM, form, plain)
    pem += made.public_bytes(serialization.Encoding.PEM)
    try:
        write_whole(file, pem.decode(), parents=True, mode=0o600)
    except OSError as error:
        raise StudioError(f"no certificate for the phone: {error.strerror} ({folder})") from error
    return file
