// Certificates and signatures by OpenSSL's libcrypto, whose headers stay out of here. Private to link/keys.
#pragma once

#include <ctime>
#include <string>

namespace foresight::link {

struct Validity {
  std::time_t from = 0, to = 0;
};

/// A key of the curve P-256 and its certificate, both as PEM.
struct Credentials {
  std::string key_pem, certificate_pem;
};

/// A new key for "CN=name", certified by `authority`, or by itself, as an authority, where that is null. Throws
/// RuntimeFailure with libcrypto's words.
Credentials make_credentials(const std::string& name, const Validity& validity, const Credentials* authority);

/// `text` with a signature beside it, S/MIME. Throws RuntimeFailure.
std::string sign(const Credentials& authority, const std::string& text);

/// What is wrong with a certificate at `now`: no certificate at all, expired, does not count yet; "" where nothing is.
std::string objection_to(const std::string& certificate_pem, std::time_t now);
bool is_made_by(const std::string& certificate_pem, const std::string& authority_pem);
bool belongs_to(const std::string& key_pem, const std::string& certificate_pem);
bool is_signed_by(const std::string& smime, const std::string& authority_pem);

}  // namespace foresight::link
