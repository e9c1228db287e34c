#!/bin/sh
# spdx.sh SOURCE_FOLDER VERSION EPOCH KIND…: prints an SPDX 2.3 document of the program and of those rows of libraries.tsv
# whose last column is among KIND, with the versions that are installed here.
set -eu
source=$1 version=$2 epoch=$3
shift 3
tab=$(printf '\t')
awk -F '\t' -v kinds="$*" '!/^#/ && index(" " kinds " ", " " $5 " ")' "$source/packaging/libraries.tsv" |
  while IFS=$tab read -r _ name licence package how; do
    upstream=$(dpkg-query -W -f '${source:Upstream-Version}' "$package" 2>/dev/null || echo NOASSERTION)
    printf '%s\t%s\t%s\t%s\t%s\n' "$name" "$licence" "$package" "$upstream" "$how"
  done | awk -F '\t' -v version="$version" -v created="$(date -u -d "@$epoch" +%Y-%m-%dT%H:%M:%SZ)" '
  function package(id, name, version, licence) {
    printf "%s    {\"SPDXID\": \"SPDXRef-%s\", \"name\": \"%s\", \"versionInfo\": \"%s\", \"licenseConcluded\": \"%s\", \"licenseDeclared\": \"%s\", \"copyrightText\": \"NOASSERTION\", \"downloadLocation\": \"NOASSERTION\", \"filesAnalyzed\": false}",
      (packages++ ? ",\n" : ""), id, name, version, licence, licence
  }
  BEGIN {
    printf "{\n  \"spdxVersion\": \"SPDX-2.3\", \"dataLicense\": \"CC0-1.0\", \"SPDXID\": \"SPDXRef-DOCUMENT\",\n"
    printf "  \"name\": \"homolog-%s\", \"documentNamespace\": \"urn:homolog:%s:%s\",\n", version, version, created
    printf "  \"creationInfo\": {\"created\": \"%s\", \"creators\": [\"Tool: packaging/spdx.sh\"]},\n", created
    printf "  \"hasExtractedLicensingInfos\": [{\"licenseId\": \"LicenseRef-public-domain\", \"name\": \"Public domain\", \"extractedText\": \"Its authors put it in the public domain.\"}],\n"
    printf "  \"packages\": [\n"
    package("homolog", "homolog", version, "MIT")
  }
  { package($3, $1, $4, $2); id[++count] = $3; inside[count] = $5 == "inside" }
  END {
    printf "\n  ],\n  \"relationships\": [\n    {\"spdxElementId\": \"SPDXRef-DOCUMENT\", \"relationshipType\": \"DESCRIBES\", \"relatedSpdxElement\": \"SPDXRef-homolog\"}"
    for (i = 1; i <= count; ++i)
      printf ",\n    {\"spdxElementId\": \"SPDXRef-homolog\", \"relationshipType\": \"%s\", \"relatedSpdxElement\": \"SPDXRef-%s\"}", inside[i] ? "CONTAINS" : "DYNAMIC_LINK", id[i]
    printf "\n  ]\n}\n"
  }'
