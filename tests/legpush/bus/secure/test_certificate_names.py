"""Names of certificates fit their common name, and no two certificates share one."""

from hypothesis import given
from hypothesis import strategies as st

from legpush.authority.register import MAX_SERIAL
from legpush.bus.secure.certificate_names import CERTIFICATE_ROLES, MAX_NAME, WORDS, CertificateRole, certificate_name

HOSTS = st.from_regex(r"[A-Za-z0-9](?:[A-Za-z0-9-]{0,38}[A-Za-z0-9])?", fullmatch=True)
ONE = st.tuples(st.sampled_from(CERTIFICATE_ROLES), HOSTS, st.integers(1, MAX_SERIAL + 1))


@given(ONE, ONE)
def test_a_name_is_short_enough_and_belongs_to_one_certificate(
    one: tuple[CertificateRole, str, int], other: tuple[CertificateRole, str, int]
) -> None:
    assert len(certificate_name(*one)) <= MAX_NAME
    assert (certificate_name(*one) == certificate_name(*other)) == (one == other)


def test_each_role_has_a_word() -> None:
    assert list(WORDS) == list(CERTIFICATE_ROLES)
