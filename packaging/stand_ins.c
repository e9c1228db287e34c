// Stand-ins for two libraries that Debian's HDF5 and libtiff are linked with and that Homolog never calls. In the portable
// archive they take the place of libcurl (HDF5 reads over a network with it; twenty more libraries lie behind it) and of
// libjbig (fax pages in TIFF; it is under the GPL). Every function fails, as the library's own may. One file makes both:
// each library takes the functions that stand_ins_NAME.map names.
#include <stddef.h>

// libcurl: no session can be begun.
void* curl_easy_init(void) { return NULL; }
int curl_easy_setopt(void* session, int option, ...) { (void)session; (void)option; return 2; }  // CURLE_FAILED_INIT
int curl_easy_perform(void* session) { (void)session; return 2; }
void curl_easy_cleanup(void* session) { (void)session; }
int curl_global_init(long flags) { (void)flags; return 2; }
void curl_global_cleanup(void) {}
void* curl_slist_append(void* list, const char* text) { (void)list; (void)text; return NULL; }
void curl_slist_free_all(void* list) { (void)list; }

// libjbig: nothing can be decoded, which libtiff reports with jbg_strerror. What encodes is never called.
void jbg_dec_init(void* decoder) { (void)decoder; }
int jbg_dec_in(void* decoder, unsigned char* data, size_t bytes, size_t* read) {
  (void)decoder; (void)data; (void)bytes;
  if (read != NULL) *read = 0;
  return 64;
}
unsigned char* jbg_dec_getimage(const void* decoder, int plane) { (void)decoder; (void)plane; return NULL; }
unsigned long jbg_dec_getsize(const void* decoder) { (void)decoder; return 0; }
void jbg_dec_free(void* decoder) { (void)decoder; }
int jbg_newlen(unsigned char* data, size_t bytes) { (void)data; (void)bytes; return 64; }
const char* jbg_strerror(int code) { (void)code; return "JBIG is not built in"; }
void jbg_enc_init(void* encoder) { (void)encoder; }
void jbg_enc_out(void* encoder) { (void)encoder; }
void jbg_enc_free(void* encoder) { (void)encoder; }
