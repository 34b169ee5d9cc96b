# The command `vog` and its library on Debian 12: docker build -t vog . && docker run -v "$PWD:/data" -w /data vog render smoke.vdb -o smoke.png
FROM debian:12 AS build
RUN apt-get update -qq && apt-get install -y -qq git
COPY . /vog
WORKDIR /vog
RUN scripts/deb.sh --no-test

FROM debian:12-slim
COPY --from=build /vog/dist/*.deb /tmp/
RUN apt-get update -qq && apt-get install -y -qq --no-install-recommends /tmp/*.deb && rm -rf /tmp/*.deb /var/lib/apt/lists/*
ENTRYPOINT ["vog"]
