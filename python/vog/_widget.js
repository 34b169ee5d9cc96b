// _widget.js: the page in an iframe, and its settings to and from Python (src/web/page/link/outer.js).
function render({ model, el }) {
  const frame = document.createElement('iframe');
  frame.style.cssText = 'width: 100%; border: 0';
  frame.setAttribute('allowfullscreen', '');
  let ready = false;
  const post = (message) => frame.contentWindow?.postMessage(message, '*');
  const send = (settings) => { if (settings) post({ vog: 'settings', settings }); };
  const listen = ({ source, data }) => {
    if (source !== frame.contentWindow || data?.vog !== 'settings') return;
    if (!ready) {
      // The page of another model takes the settings of the one before.
      ready = true;
      send(model.get('link'));
      send(model.get('sent').replace(/^\d+ /, ''));
      return;
    }
    model.set('link', data.settings);
    model.save_changes();
  };
  const load = () => { ready = false; frame.srcdoc = model.get('html'); };
  const resize = () => { frame.style.height = `${model.get('height')}px`; };
  const forward = () => { if (ready) send(model.get('sent').replace(/^\d+ /, '')); };
  window.addEventListener('message', listen);
  frame.addEventListener('load', () => post({ vog: 'get' }));
  model.on('change:html', load);
  model.on('change:height', resize);
  model.on('change:sent', forward);
  resize();
  load();
  el.append(frame);
  return () => {
    window.removeEventListener('message', listen);
    model.off('change:html', load);
    model.off('change:height', resize);
    model.off('change:sent', forward);
  };
}
export default { render };
