#include "link/keys/certificates.hpp"

#include <fmt/core.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/rand.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <memory>

#include "common/error.hpp"

namespace foresight::link {
namespace {

template <auto Free>
struct Deleter {
  template <typename T>
  void operator()(T* object) const noexcept {
    Free(object);
  }
};
using Bio = std::unique_ptr<BIO, Deleter<BIO_free_all>>;
using Key = std::unique_ptr<EVP_PKEY, Deleter<EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, Deleter<X509_free>>;
using Extension = std::unique_ptr<X509_EXTENSION, Deleter<X509_EXTENSION_free>>;
using Signature = std::unique_ptr<PKCS7, Deleter<PKCS7_free>>;
using Store = std::unique_ptr<X509_STORE, Deleter<X509_STORE_free>>;

[[noreturn]] void fail(const char* what) {
  char words[256] = "no reason";
  if (const unsigned long code = ERR_get_error()) ERR_error_string_n(code, words, sizeof words);
  throw RuntimeFailure(fmt::format("{}: libcrypto says '{}'", what, words), "see whether OpenSSL 3 is installed whole");
}
void require(bool good, const char* what) {
  if (!good) fail(what);
}

Bio reading(const std::string& text) {
  return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}
std::string content(BIO* bio) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(bio, &data);
  return {data, static_cast<std::size_t>(size)};
}
Certificate certificate_of(const std::string& pem) {
  Certificate out(PEM_read_bio_X509(reading(pem).get(), nullptr, nullptr, nullptr));
  ERR_clear_error();
  return out;
}
Key key_of(const std::string& pem) {
  Key out(PEM_read_bio_PrivateKey(reading(pem).get(), nullptr, nullptr, nullptr));
  ERR_clear_error();
  return out;
}

void set_extension(X509* of, X509* issuer, int kind, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, issuer, of, nullptr, nullptr, 0);
  const Extension extension(X509V3_EXT_conf_nid(nullptr, &context, kind, value));
  require(extension && X509_add_ext(of, extension.get(), -1) == 1, "a certificate's extension cannot be set");
}

void name_it(X509* certificate, const std::string& name, X509* issuer) {
  X509_NAME* const subject = X509_get_subject_name(certificate);
  const auto* const text = reinterpret_cast<const unsigned char*>(name.c_str());
  require(X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_UTF8, text, -1, -1, 0) == 1 &&
              X509_set_issuer_name(certificate, X509_get_subject_name(issuer)) == 1,
          "a certificate cannot be named");
}

std::string date_text(const ASN1_TIME* time) {
  const Bio out(BIO_new(BIO_s_mem()));
  ASN1_TIME_print(out.get(), time);
  return content(out.get());
}

}  // namespace

Credentials make_credentials(const std::string& name, const Validity& validity, const Credentials* authority) {
  const Key key(EVP_EC_gen("P-256"));
  require(key != nullptr, "a key cannot be made");
  const Key signing = authority ? key_of(authority->key_pem) : nullptr;
  const Certificate issuer = authority ? certificate_of(authority->certificate_pem) : nullptr;
  const Certificate made(X509_new());
  std::uint64_t serial = 0;
  require(made && RAND_bytes(reinterpret_cast<unsigned char*>(&serial), sizeof serial) == 1, "a certificate");
  X509_set_version(made.get(), X509_VERSION_3);
  ASN1_INTEGER_set_uint64(X509_get_serialNumber(made.get()), serial >> 1);
  ASN1_TIME_set(X509_getm_notBefore(made.get()), validity.from);
  ASN1_TIME_set(X509_getm_notAfter(made.get()), validity.to);
  X509* const by = issuer ? issuer.get() : made.get();
  name_it(made.get(), name, by);
  require(X509_set_pubkey(made.get(), key.get()) == 1, "a certificate cannot take its key");
  set_extension(made.get(), by, NID_basic_constraints, authority ? "critical,CA:FALSE" : "critical,CA:TRUE");
  set_extension(made.get(), by, NID_subject_key_identifier, "hash");
  require(X509_sign(made.get(), signing ? signing.get() : key.get(), EVP_sha256()) > 0,
          "a certificate cannot be signed");
  const Bio certificate_pem(BIO_new(BIO_s_mem())), key_pem(BIO_new(BIO_s_mem()));
  require(PEM_write_bio_X509(certificate_pem.get(), made.get()) == 1 &&
              PEM_write_bio_PrivateKey(key_pem.get(), key.get(), nullptr, nullptr, 0, nullptr, nullptr) == 1,
          "a certificate cannot be written");
  return {content(key_pem.get()), content(certificate_pem.get())};
}

std::string sign(const Credentials& authority, const std::string& text) {
  const Certificate certificate = certificate_of(authority.certificate_pem);
  const Key key = key_of(authority.key_pem);
  const Bio in = reading(text), out(BIO_new(BIO_s_mem()));
  constexpr int kFlags = PKCS7_DETACHED | PKCS7_TEXT;
  const Signature signature(PKCS7_sign(certificate.get(), key.get(), nullptr, in.get(), kFlags));
  require(signature != nullptr, "a text cannot be signed");
  BIO_reset(in.get());
  require(SMIME_write_PKCS7(out.get(), signature.get(), in.get(), kFlags) == 1, "a signed text cannot be written");
  return content(out.get());
}

std::string objection_to(const std::string& certificate_pem, std::time_t now) {
  const Certificate certificate = certificate_of(certificate_pem);
  if (!certificate) return "is no certificate";
  const ASN1_TIME *const from = X509_get0_notBefore(certificate.get()), *const to =
                                                                            X509_get0_notAfter(certificate.get());
  if (X509_cmp_time(to, &now) < 0) return "has expired on " + date_text(to);
  if (X509_cmp_time(from, &now) > 0)
    return "does not count before " + date_text(from) + "; this host's clock may be wrong";
  return "";
}

bool is_made_by(const std::string& certificate_pem, const std::string& authority_pem) {
  const Certificate certificate = certificate_of(certificate_pem), authority = certificate_of(authority_pem);
  const bool out = certificate && authority && X509_check_issued(authority.get(), certificate.get()) == X509_V_OK &&
                   X509_verify(certificate.get(), X509_get0_pubkey(authority.get())) == 1;
  ERR_clear_error();
  return out;
}

bool belongs_to(const std::string& key_pem, const std::string& certificate_pem) {
  const Certificate certificate = certificate_of(certificate_pem);
  const Key key = key_of(key_pem);
  const bool out = certificate && key && X509_check_private_key(certificate.get(), key.get()) == 1;
  ERR_clear_error();
  return out;
}

bool is_signed_by(const std::string& smime, const std::string& authority_pem) {
  BIO* raw_content = nullptr;
  const Signature signature(SMIME_read_PKCS7(reading(smime).get(), &raw_content));
  const Bio text(raw_content), out(BIO_new(BIO_s_mem()));
  const Certificate authority = certificate_of(authority_pem);
  const Store store(X509_STORE_new());
  if (!signature || !authority || !store || X509_STORE_add_cert(store.get(), authority.get()) != 1) {
    ERR_clear_error();
    return false;
  }
  const bool good = PKCS7_verify(signature.get(), nullptr, store.get(), text.get(), out.get(), PKCS7_TEXT) == 1;
  ERR_clear_error();
  return good;
}

}  // namespace foresight::link
